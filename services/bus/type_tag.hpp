// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastdds/dds/topic/TypeSupport.hpp>

#include "fast_dds/names.hpp"

namespace stillhand::runtime {

/// The content of TypeTag; only the .cpp files of this folder see it.
struct TypeTag {
  edds::TypeSupport support;
};

/// Type support by DDS type name, for the recorder; nullptr when idl/ does not define it.
const TypeTag* find_type(std::string_view type_name);

}  // namespace stillhand::runtime
