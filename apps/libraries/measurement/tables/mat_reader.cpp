// SPDX-License-Identifier: Apache-2.0
// MATLAB files of version 5 and 7.3: numeric variables, and structs of them to any depth.
#include <matio.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>

#include "apps/libraries/measurement/tables/guarded_table.hpp"
#include "apps/libraries/measurement/tables/in_child.hpp"
#include "apps/libraries/measurement/tables/titles.hpp"

namespace stillhand::measurement {
namespace {

// A matrix has a column for each signal; an image has more.
constexpr std::size_t kMostSignals = 64;
constexpr std::size_t kMostElements = 1024;  // of a struct or cell array: dSPACE has one a signal
constexpr int kMostDepth = 16;

struct VariableFree {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using Variable = std::unique_ptr<matvar_t, VariableFree>;

struct MatClose {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
using MatFile = std::unique_ptr<mat_t, MatClose>;

MatFile open_mat(const std::string& path) {
  MatFile file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file) throw Refused{path, "a MATLAB file that is damaged or cut off", "a whole .mat file"};
  return file;
}

bool is_numeric(const matvar_t& variable) {
  return variable.class_type >= MAT_C_DOUBLE && variable.class_type <= MAT_C_UINT64 &&
         variable.dims != nullptr;
}

template <typename Number>
void copy_numbers(const matvar_t& variable, std::size_t first, std::size_t step,
                  std::vector<double>& out) {
  const auto* values = static_cast<const Number*>(variable.data);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<double>(values[first + i * step]);
  }
}

// @returns false if the data are not there, or are fewer than the head states
bool copy(const matvar_t& variable, std::size_t first, std::size_t step, std::vector<double>& out) {
  const std::size_t last = first + (out.size() - 1) * step;
  const std::size_t size = Mat_SizeOf(variable.data_type);
  if (variable.data == nullptr || size == 0 || last >= variable.nbytes / size) return false;
  switch (variable.data_type) {
    case MAT_T_DOUBLE:
      copy_numbers<double>(variable, first, step, out);
      return true;
    case MAT_T_SINGLE:
      copy_numbers<float>(variable, first, step, out);
      return true;
    case MAT_T_INT8:
      copy_numbers<std::int8_t>(variable, first, step, out);
      return true;
    case MAT_T_UINT8:
      copy_numbers<std::uint8_t>(variable, first, step, out);
      return true;
    case MAT_T_INT16:
      copy_numbers<std::int16_t>(variable, first, step, out);
      return true;
    case MAT_T_UINT16:
      copy_numbers<std::uint16_t>(variable, first, step, out);
      return true;
    case MAT_T_INT32:
      copy_numbers<std::int32_t>(variable, first, step, out);
      return true;
    case MAT_T_UINT32:
      copy_numbers<std::uint32_t>(variable, first, step, out);
      return true;
    case MAT_T_INT64:
      copy_numbers<std::int64_t>(variable, first, step, out);
      return true;
    case MAT_T_UINT64:
      copy_numbers<std::uint64_t>(variable, first, step, out);
      return true;
    default:
      return false;
  }
}

std::string text_of(const matvar_t* variable) {
  if (variable == nullptr || variable->class_type != MAT_C_CHAR || variable->data == nullptr) {
    return {};
  }
  std::string out;
  if (variable->data_size == 1) {
    out.assign(static_cast<const char*>(variable->data), variable->nbytes);
  } else if (variable->data_size == 2) {
    const auto* units = static_cast<const std::uint16_t*>(variable->data);
    for (std::size_t i = 0; i < variable->nbytes / 2; ++i) {
      if (units[i] < 0x80) {
        out += static_cast<char>(units[i]);
      } else if (units[i] < 0x800) {
        out += static_cast<char>(0xC0 | (units[i] >> 6));
        out += static_cast<char>(0x80 | (units[i] & 0x3F));
      }
    }
  }
  return out;
}

matvar_t* field_of(matvar_t* structure, const char* name, std::size_t element = 0) {
  if (structure == nullptr || structure->class_type != MAT_C_STRUCT) return nullptr;
  return Mat_VarGetStructFieldByName(structure, name, element);
}

constexpr std::array<const char*, 4> kUnitFields{"Unit", "unit", "Units", "units"};

// The unit of a struct's field: of a table or timetable (Properties), of a timeseries (DataInfo,
// TimeInfo), of `stillhand export` (meta.units), or a text next to it, which is not that of times.
std::string unit_of(matvar_t* structure, const std::string& field, std::size_t element) {
  if (const std::string unit =
          text_of(field_of(field_of(field_of(structure, "meta"), "units"), field.c_str()));
      !unit.empty()) {
    return unit;
  }
  matvar_t* properties = field_of(structure, "Properties", element);
  matvar_t* names = field_of(properties, "VariableNames");
  matvar_t* units = field_of(properties, "VariableUnits");
  if (names != nullptr && units != nullptr && names->class_type == MAT_C_CELL &&
      units->class_type == MAT_C_CELL && names->nbytes == units->nbytes) {
    const std::size_t count = names->data_size > 0 ? names->nbytes / names->data_size : 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (text_of(Mat_VarGetCell(names, static_cast<int>(i))) == field) {
        return text_of(Mat_VarGetCell(units, static_cast<int>(i)));
      }
    }
  }
  const std::string info = field + "Info";
  if (std::string unit = text_of(field_of(field_of(structure, info.c_str(), element), "Units"));
      !unit.empty() || field == "Time" || field == "time" || field == "t") {
    return unit;
  }
  for (const char* name : kUnitFields) {
    if (std::string unit = text_of(field_of(structure, name, element)); !unit.empty()) return unit;
  }
  return {};
}

// Some struct in it has a field that holds units: its texts must be read too.
bool states_units(matvar_t* variable, int depth) {
  if (variable == nullptr || depth > kMostDepth) return false;
  if (variable->class_type == MAT_C_CELL && variable->rank == 2 && variable->dims != nullptr) {
    const std::size_t count = std::min(variable->dims[0] * variable->dims[1], kMostElements);
    for (std::size_t i = 0; i < count; ++i) {
      if (states_units(Mat_VarGetCell(variable, static_cast<int>(i)), depth + 1)) return true;
    }
  }
  if (variable->class_type != MAT_C_STRUCT) return false;
  for (const char* name : {"meta", "Properties", "DataInfo"}) {
    if (field_of(variable, name) != nullptr) return true;
  }
  const auto stated = [&](const char* name) { return field_of(variable, name) != nullptr; };
  if (std::ranges::any_of(kUnitFields, stated)) return true;
  for (unsigned f = 0; f < Mat_VarGetNumberOfFields(variable); ++f) {
    if (states_units(Mat_VarGetStructFieldByIndex(variable, f, 0), depth + 1)) return true;
  }
  return false;
}

// Walks over the columns of a variable, in the same order whether its data are loaded or not.
class ColumnWalk {
 public:
  virtual ~ColumnWalk() = default;
  // @param first, step  place of the values in the variable's data
  virtual void take(const std::string& title, const std::string& unit, const matvar_t& variable,
                    std::size_t first, std::size_t step, std::size_t rows) = 0;
  // A variable that cannot be a column, and why.
  virtual void leave_out(const std::string& /*title*/, const std::string& /*why*/) {}

  void walk(matvar_t* variable, const std::string& title, const std::string& unit, int depth) {
    if (variable == nullptr || depth > kMostDepth) return;
    if (is_numeric(*variable)) {
      numbers(*variable, title, unit);
    } else if (variable->class_type == MAT_C_STRUCT) {
      structure(variable, title, depth);
    } else if (variable->class_type == MAT_C_CELL) {
      cells(variable, title, depth);
    }
  }

 private:
  void numbers(const matvar_t& variable, const std::string& title, const std::string& unit) {
    if (variable.isComplex != 0) return leave_out(title, "complex numbers");
    if (variable.rank != 2) return leave_out(title, std::to_string(variable.rank) + " dimensions");
    const std::size_t down = variable.dims[0];
    const std::size_t across = variable.dims[1];
    const bool along_rows = down >= across;
    const std::size_t rows = along_rows ? down : across;
    const std::size_t signals = along_rows ? across : down;
    if (rows < 2 || signals < 1) return;
    if (signals > kMostSignals) {
      return leave_out(title, std::to_string(signals) + " signals in one matrix");
    }
    for (std::size_t i = 0; i < signals; ++i) {
      const std::string number = std::to_string(i + 1);
      const std::string name =
          signals == 1 ? title : title + (along_rows ? "(:," + number + ")" : "(" + number + ",:)");
      take(name, unit, variable, along_rows ? i * down : i, along_rows ? 1 : down, rows);
    }
  }

  void structure(matvar_t* variable, const std::string& title, int depth) {
    char* const* names = Mat_VarGetStructFieldnames(variable);
    const unsigned fields = Mat_VarGetNumberOfFields(variable);
    if (names == nullptr || variable->rank != 2 || variable->dims == nullptr) return;
    const std::size_t elements = variable->dims[0] * variable->dims[1];
    if (elements > kMostElements) {
      return leave_out(title, std::to_string(elements) + " elements");
    }
    for (std::size_t e = 0; e < elements; ++e) {
      const std::string at = elements == 1 ? "" : "(" + std::to_string(e + 1) + ")";
      for (unsigned f = 0; f < fields; ++f) {
        if (names[f] == nullptr) continue;
        walk(Mat_VarGetStructFieldByIndex(variable, f, e), title + at + "." + names[f],
             unit_of(variable, names[f], e), depth + 1);
      }
    }
  }

  void cells(matvar_t* variable, const std::string& title, int depth) {
    if (variable->rank != 2 || variable->dims == nullptr) return;
    const std::size_t elements = variable->dims[0] * variable->dims[1];
    if (elements > kMostElements) {
      return leave_out(title, std::to_string(elements) + " cells");
    }
    for (std::size_t e = 0; e < elements; ++e) {
      walk(Mat_VarGetCell(variable, static_cast<int>(e)), title + "{" + std::to_string(e + 1) + "}",
           {}, depth + 1);
    }
  }
};

class HeadWalk : public ColumnWalk {
 public:
  std::vector<ColumnHead> heads;
  std::vector<std::string> left_out;  // "spectrum (complex numbers)"
  void take(const std::string& title, const std::string& unit, const matvar_t& /*variable*/,
            std::size_t /*first*/, std::size_t /*step*/, std::size_t rows) override {
    heads.push_back({title, title, unit == "?" ? "" : unit, rows});
  }
  void leave_out(const std::string& title, const std::string& why) override {
    left_out.push_back(title + " (" + why + ")");
  }
};

class ValueWalk : public ColumnWalk {
 public:
  std::vector<std::vector<double>> values;

  ValueWalk(const std::string& path, const TableHead& head, const std::vector<std::size_t>& wanted)
      : values(wanted.size()), path_(path), head_(head), wanted_(wanted) {}
  void take(const std::string& title, const std::string& /*unit*/, const matvar_t& variable,
            std::size_t first, std::size_t step, std::size_t rows) override {
    for (std::size_t i = 0; i < wanted_.size(); ++i) {
      const ColumnHead& column = head_.columns[wanted_[i]];
      if (column.title != title || column.rows != rows) continue;
      values[i].resize(rows);
      if (!copy(variable, first, step, values[i])) {
        throw Refused{path_, "the variable '" + title + "', which cannot be read", "a whole file"};
      }
    }
  }

 private:
  const std::string& path_;
  const TableHead& head_;
  const std::vector<std::size_t>& wanted_;
};

// Of version 5 (MathWorks, "MAT-File Format"): an element reaches beyond the end of the file.
bool is_cut_off(const std::string& path) {
  constexpr std::uint64_t kHead_bytes = 128;
  std::ifstream file(path, std::ios::binary);
  const std::uint64_t size = std::filesystem::file_size(path);
  std::array<std::uint32_t, 2> tag{};  // kind and bytes of an element
  std::uint64_t at = kHead_bytes;
  while (at + sizeof tag <= size && file.seekg(static_cast<std::streamoff>(at)) &&
         file.read(reinterpret_cast<char*>(tag.data()), sizeof tag)) {
    at += sizeof tag + tag[1];
  }
  return at > size;
}

TableHead mat_head(const std::string& path) {
  const MatFile file = open_mat(path);
  std::vector<std::string> names;
  std::vector<std::string> objects;
  for (Variable info(Mat_VarReadNextInfo(file.get())); info;
       info.reset(Mat_VarReadNextInfo(file.get()))) {
    if (info->name == nullptr) continue;
    const bool object = info->class_type == MAT_C_OPAQUE || info->class_type == MAT_C_OBJECT;
    (object ? objects : names).emplace_back(info->name);
  }
  HeadWalk walk;
  for (const std::string& name : names) {
    Variable variable(Mat_VarReadInfo(file.get(), name.c_str()));
    if (!variable) continue;
    if (states_units(variable.get(), 0)) {
      variable.reset(Mat_VarRead(file.get(), name.c_str()));
    }
    walk.walk(variable.get(), name, {}, 0);
  }
  if (walk.heads.empty()) {
    std::string got = "a MATLAB file without a column of numbers";
    if (!walk.left_out.empty()) got += ", but " + listed(walk.left_out);
    if (!objects.empty()) got = "objects of MATLAB (" + listed(objects) + ") alone";
    throw Refused{
        path, got,
        "real arrays, or structs and cells of them: save a timetable or timeseries as its "
        "arrays"};
  }
  TableHead head;
  head.path = path;
  head.form = Mat_GetVersion(file.get()) == MAT_FT_MAT73 ? "MATLAB 7.3" : "MATLAB 5";
  head.columns = std::move(walk.heads);
  if (!objects.empty()) {
    head.notes.push_back("Objects of MATLAB are not read: " + listed(objects) + ".");
  }
  if (Mat_GetVersion(file.get()) == MAT_FT_MAT5 && Mat_GetHeader(file.get()) != nullptr &&
      is_cut_off(path)) {
    head.notes.emplace_back("The file is cut off: its last variables are not there.");
  }
  if (!walk.left_out.empty()) head.notes.push_back("Not read: " + listed(walk.left_out) + ".");
  return head;
}

// "a" of "a.b(:,1)"
std::string variable_of(const std::string& title) {
  return title.substr(0, title.find_first_of(".({"));
}

RawColumns mat_values(const std::string& path, const TableHead& head,
                      const std::vector<std::size_t>& columns) {
  const MatFile file = open_mat(path);
  ValueWalk walk(path, head, columns);
  std::vector<std::string> names;
  for (const std::size_t column : columns) {
    std::string name = variable_of(head.columns[column].title);
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  }
  for (const std::string& name : names) {
    const Variable variable(Mat_VarRead(file.get(), name.c_str()));
    walk.walk(variable.get(), name, {}, 0);
  }
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (walk.values[i].size() == head.columns[columns[i]].rows) continue;
    throw Refused{path,
                  "the variable '" + head.columns[columns[i]].title + "', which cannot be read",
                  "a whole file"};
  }
  RawColumns out;
  out.values = std::move(walk.values);
  return out;
}

}  // namespace

BinaryReader mat_reader() { return {mat_head, mat_values}; }

}  // namespace stillhand::measurement
