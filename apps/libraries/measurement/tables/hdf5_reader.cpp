// SPDX-License-Identifier: Apache-2.0
// HDF5 files: data sets of one or two dimensions, and tables (compound types).
#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string_view>
#include <utility>

#include "apps/libraries/measurement/tables/guarded_table.hpp"
#include "apps/libraries/measurement/tables/in_child.hpp"
#include "apps/libraries/measurement/tables/titles.hpp"

namespace stillhand::measurement {
namespace {

// A matrix has a column for each signal; an image has more.
constexpr hsize_t kMostMatrixSignals = 64;

class Id {
 public:
  using Close = herr_t (*)(hid_t);
  Id(hid_t id, Close at_end) : id_(id), close_(at_end) {}
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id& operator=(Id&&) = delete;
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const noexcept { return id_; }

 private:
  hid_t id_;
  Close close_;
};

// One column: where its values lie.
struct Place {
  std::string set;     // path of the data set
  std::string member;  // of a table; empty: none
  bool in_matrix = false;
  bool along_rows = true;  // of a matrix: the signal is a column of it
  hsize_t index = 0;       // of the signal in the matrix
};

struct Found {
  std::vector<ColumnHead> heads;
  std::vector<Place> places;
  std::vector<std::string> left_out;  // "log.pose (a compound in a compound)"
};

std::string class_name(hid_t type) {
  switch (H5Tget_class(type)) {
    case H5T_STRING:
      return "text";
    case H5T_COMPOUND:
      return "a compound";
    case H5T_ENUM:
      return "an enumeration";
    case H5T_ARRAY:
      return "arrays";
    case H5T_VLEN:
      return "lists";
    default:
      return "no numbers";
  }
}

bool is_number(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

// A text attribute, of fixed or variable length.
std::string text_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return {};
  const Id attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Id type(H5Aget_type(attribute), H5Tclose);
  const Id space(H5Aget_space(attribute), H5Sclose);
  if (attribute < 0 || type < 0 || H5Tget_class(type) != H5T_STRING ||
      H5Sget_simple_extent_npoints(space) != 1) {
    return {};
  }
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    if (H5Aread(attribute, type, &text) < 0 || text == nullptr) return {};
    std::string out(text);
    H5free_memory(text);
    return out;
  }
  std::string out(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, out.data()) < 0) return {};
  out.resize(std::min(out.find('\0'), out.size()));
  return out;
}

// A number that an attribute of one element holds.
std::optional<double> number_attribute(hid_t object, const char* name) {
  if (H5Aexists(object, name) <= 0) return std::nullopt;
  const Id attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const Id type(H5Aget_type(attribute), H5Tclose);
  const Id space(H5Aget_space(attribute), H5Sclose);
  double value = 0.0;
  if (attribute < 0 || !is_number(type) || H5Sget_simple_extent_npoints(space) != 1 ||
      H5Aread(attribute, H5T_NATIVE_DOUBLE, &value) < 0) {
    return std::nullopt;
  }
  return value;
}

// Both ends of `valid_range`, or what `valid_min` and `valid_max` state.
std::array<double, 2> valid_range(hid_t set) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::array<double, 2> ends{number_attribute(set, "valid_min").value_or(-kNone),
                             number_attribute(set, "valid_max").value_or(kNone)};
  if (H5Aexists(set, "valid_range") <= 0) return ends;
  const Id attribute(H5Aopen(set, "valid_range", H5P_DEFAULT), H5Aclose);
  const Id space(H5Aget_space(attribute), H5Sclose);
  const Id type(H5Aget_type(attribute), H5Tclose);
  if (is_number(type) && H5Sget_simple_extent_npoints(space) == 2) {
    (void)H5Aread(attribute, H5T_NATIVE_DOUBLE, ends.data());
  }
  return ends;
}

// Values of a set that is packed by the conventions of netCDF (its users' guide, appendix A; CF
// 1.11, sections 2.5.1 and 8.1): the sign, what is missing, then a factor and an offset.
std::string unpack(hid_t set, std::vector<double>& values) {
  if (const Id type(H5Dget_type(set), H5Tclose); text_attribute(set, "_Unsigned") == "true") {
    const double range = std::exp2(8.0 * static_cast<double>(H5Tget_size(type)));
    for (double& value : values) value += value < 0.0 ? range : 0.0;
  }
  const auto [low, high] = valid_range(set);
  std::ranges::replace_if(
      values, [low = low, high = high](double value) { return value < low || value > high; },
      std::numeric_limits<double>::quiet_NaN());
  for (const char* name : {"_FillValue", "missing_value"}) {
    const std::optional<double> missing = number_attribute(set, name);
    if (missing) std::ranges::replace(values, *missing, std::numeric_limits<double>::quiet_NaN());
  }
  const double factor = number_attribute(set, "scale_factor").value_or(1.0);
  const double offset = number_attribute(set, "add_offset").value_or(0.0);
  if (factor == 1.0 && offset == 0.0) return {};
  for (double& value : values) value = value * factor + offset;
  return fmt::format("stored numbers times {:.6g} plus {:.6g} (scale_factor, add_offset)", factor,
                     offset);
}

std::string unit_of(hid_t set) {
  for (const char* name : {"unit", "units", "Unit", "Units"}) {
    std::string unit = text_attribute(set, name);
    unit.resize(
        std::min(unit.find(" since "), unit.size()));  // of times: the beginning is not used
    if (!unit.empty()) return unit;
  }
  return {};
}

void add_table(hid_t type, const std::string& path, hsize_t rows, Found& found) {
  const int members = H5Tget_nmembers(type);
  for (int i = 0; i < members; ++i) {
    const Id member(H5Tget_member_type(type, static_cast<unsigned>(i)), H5Tclose);
    char* raw = H5Tget_member_name(type, static_cast<unsigned>(i));
    const std::string name = raw == nullptr ? "" : raw;
    H5free_memory(raw);
    if (name.empty()) continue;
    if (!is_number(member)) {
      found.left_out.push_back(fmt::format("{}.{} ({})", path, name, class_name(member)));
      continue;
    }
    const std::string title = fmt::format("{}.{}", path, name);
    found.heads.push_back({title, title, {}, rows});
    found.places.push_back({path, name});
  }
}

void add_matrix(const std::string& path, const std::array<hsize_t, 2>& size,
                const std::string& unit, Found& found) {
  const bool along_rows = size[0] >= size[1];
  const hsize_t rows = along_rows ? size[0] : size[1];
  const hsize_t signals = along_rows ? size[1] : size[0];
  if (signals > kMostMatrixSignals) {
    found.left_out.push_back(path + " (" + std::to_string(signals) + " signals in one matrix)");
    return;
  }
  for (hsize_t i = 0; i < signals; ++i) {
    const std::string title = signals == 1 ? path
                              : along_rows ? fmt::format("{}[:,{}]", path, i)
                                           : fmt::format("{}[{},:]", path, i);
    found.heads.push_back({title, title, unit, rows});
    found.places.push_back({path, {}, true, along_rows, i});
  }
}

void add_set(hid_t file, const std::string& path, Found& found) {
  const Id set(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  if (set < 0) return;
  const Id type(H5Dget_type(set), H5Tclose);
  const Id space(H5Dget_space(set), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space);
  std::array<hsize_t, 2> size{};
  if (rank > 2) found.left_out.push_back(path + " (" + std::to_string(rank) + " dimensions)");
  if (rank < 1 || rank > 2 || H5Sget_simple_extent_dims(space, size.data(), nullptr) < 0) return;
  if (size[0] < 1 || (rank == 2 && size[1] < 1)) return;
  if (rank == 1 && H5Tget_class(type) == H5T_COMPOUND) {
    add_table(type, path, size[0], found);
  } else if (rank == 1 && is_number(type) && size[0] > 1) {
    found.heads.push_back({path, path, unit_of(set), size[0]});
    found.places.push_back({path, {}});
  } else if (rank == 2 && is_number(type) && std::max(size[0], size[1]) > 1) {
    add_matrix(path, size, unit_of(set), found);
  } else if (!is_number(type)) {
    found.left_out.push_back(path + " (" + class_name(type) + ")");
  }
}

Id open_file(const std::string& path) {
  // Failures are reported by return values; the library would also print its stack.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Id file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (file < 0) throw Refused{path, "an HDF5 file that is damaged or cut off", "a whole HDF5 file"};
  return file;
}

// Every object once, by hard links alone: a link to another file is not followed.
Found find_sets(const std::string& path) {
  const Id file = open_file(path);
  struct Walk {
    std::vector<std::string> sets;
  } walk;
  const auto visit = [](hid_t /*group*/, const char* name, const H5O_info_t* info, void* into) {
    if (info->type == H5O_TYPE_DATASET) static_cast<Walk*>(into)->sets.emplace_back(name);
    return herr_t{0};
  };
  if (H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, visit, &walk, H5O_INFO_BASIC) < 0) {
    throw Refused{path, "an HDF5 file with damaged groups", "a whole HDF5 file"};
  }
  Found found;
  for (const std::string& set : walk.sets) add_set(file, set, found);
  return found;
}

TableHead hdf5_head(const std::string& path) {
  TableHead head;
  head.path = path;
  head.form = "HDF5";
  Found found = find_sets(path);
  if (found.heads.empty() && !found.left_out.empty()) {
    throw Refused{path, "an HDF5 file without a column of numbers, but " + listed(found.left_out),
                  "data sets of numbers with one or two dimensions, or tables of numbers"};
  }
  head.columns = std::move(found.heads);
  if (!found.left_out.empty()) head.notes.push_back("Not read: " + listed(found.left_out) + ".");
  return head;
}

std::vector<double> values_at(hid_t file, const Place& place, std::size_t rows,
                              const std::string& path, std::vector<std::string>& notes) {
  std::vector<double> values(rows);
  const Id set(H5Dopen2(file, place.set.c_str(), H5P_DEFAULT), H5Dclose);
  const Id file_space(H5Dget_space(set), H5Sclose);
  const hsize_t count = rows;
  const Id memory_space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  if (place.in_matrix) {
    const std::array<hsize_t, 2> start{place.along_rows ? 0 : place.index,
                                       place.along_rows ? place.index : 0};
    const std::array<hsize_t, 2> size{place.along_rows ? count : 1, place.along_rows ? 1 : count};
    H5Sselect_hyperslab(file_space, H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
  }
  Id type(H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose);
  if (!place.member.empty()) {
    Id table(H5Tcreate(H5T_COMPOUND, sizeof(double)), H5Tclose);
    H5Tinsert(table, place.member.c_str(), 0, H5T_NATIVE_DOUBLE);
    if (H5Dread(set, table, memory_space, file_space, H5P_DEFAULT, values.data()) >= 0) {
      return values;
    }
  } else if (H5Dread(set, type, memory_space, file_space, H5P_DEFAULT, values.data()) >= 0) {
    if (const std::string how = unpack(set, values); !how.empty()) {
      notes.push_back(place.set + ": " + how + ".");
    }
    return values;
  }
  throw Refused{path, "the data set " + place.set + ", which cannot be read",
                "a whole file, with a compression that HDF5 itself knows (gzip, szip)"};
}

RawColumns hdf5_values(const std::string& path, const TableHead& head,
                       const std::vector<std::size_t>& columns) {
  const Found found = find_sets(path);
  const Id file = open_file(path);
  RawColumns out;
  for (const std::size_t column : columns) {
    const ColumnHead& wanted = head.columns[column];
    if (column >= found.heads.size() || found.heads[column].rows != wanted.rows) {
      throw Refused{path, "a file that changes while it is read", "a file at rest"};
    }
    out.values.push_back(values_at(file, found.places[column], wanted.rows, path, out.notes));
  }
  return out;
}

}  // namespace

BinaryReader hdf5_reader() { return {hdf5_head, hdf5_values}; }

}  // namespace stillhand::measurement
