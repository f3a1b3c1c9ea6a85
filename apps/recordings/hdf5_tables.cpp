// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/hdf5_tables.hpp"

#include <hdf5.h>

#include <stdexcept>
#include <utility>

#include "apps/recordings/held_columns.hpp"
#include "apps/recordings/pending_file.hpp"

namespace stillhand::recordings {
namespace {

using recording::Cell;
using recording::CellKind;

constexpr hsize_t kBlockRows = 8192;  // 64 KiB of numbers: what is packed and read as one
constexpr std::size_t kLongestHdf5Name = 255;

/// An identifier of the library, closed at its end.
class Id {
 public:
  using Close = herr_t (*)(hid_t);
  Id(hid_t id, Close at_end, const std::string& path) : id_(id), close_(at_end) {
    if (id < 0) throw std::runtime_error(path + ": cannot be written; is the disk full?");
  }
  Id(Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Id& operator=(Id&&) = delete;
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const noexcept { return id_; }
  /// Closes now, where failing matters.
  herr_t close() { return close_(std::exchange(id_, -1)); }

 private:
  hid_t id_;
  Close close_;
};

void require_done(herr_t outcome, const std::string& path) {
  if (outcome < 0) throw std::runtime_error(path + ": cannot be written; is the disk full?");
}

Id text_type(const std::string& path) {
  Id type(H5Tcopy(H5T_C_S1), H5Tclose, path);
  require_done(H5Tset_size(type, H5T_VARIABLE), path);
  require_done(H5Tset_cset(type, H5T_CSET_UTF8), path);
  return type;
}

void put_attribute(hid_t object, const char* name, const std::string& text,
                   const std::string& path) {
  const Id type = text_type(path);
  const Id space(H5Screate(H5S_SCALAR), H5Sclose, path);
  const Id attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                     path);
  const char* value = text.c_str();
  require_done(H5Awrite(attribute, type, &value), path);
}

// One data set; rows gather here until a block is full.
class Column {
 public:
  Column(hid_t group, const ColumnHead& head, const std::string& path)
      : path_(path),
        values_{head.kind},
        type_(memory_type(head.kind, path)),
        set_(make(group, head.name)) {
    if (!head.unit.empty()) put_attribute(set_, "unit", head.unit, path);
  }

  void take(const Cell& cell) {
    values_.take(cell);
    if (++held_ == kBlockRows) write();
  }

  void write() {
    if (held_ == 0) return;
    const hsize_t first = rows_;
    rows_ += held_;
    require_done(H5Dset_extent(set_, &rows_), path_);
    const Id file_space(H5Dget_space(set_), H5Sclose, path_);
    require_done(H5Sselect_hyperslab(file_space, H5S_SELECT_SET, &first, nullptr, &held_, nullptr),
                 path_);
    const Id memory_space(H5Screate_simple(1, &held_, nullptr), H5Sclose, path_);
    std::vector<const char*> pointers;
    for (const std::string& text : values_.texts) pointers.push_back(text.c_str());
    const CellKind kind = values_.kind;
    const void* first_value =
        kind == CellKind::kInteger    ? static_cast<const void*>(values_.integers.data())
        : kind == CellKind::kUnsigned ? values_.unsigneds.data()
        : kind == CellKind::kReal     ? static_cast<const void*>(values_.reals.data())
                                      : pointers.data();
    require_done(H5Dwrite(set_, type_, memory_space, file_space, H5P_DEFAULT, first_value), path_);
    values_.clear();
    held_ = 0;
  }

 private:
  static Id memory_type(CellKind kind, const std::string& path) {
    if (kind == CellKind::kText) return text_type(path);
    const hid_t type = kind == CellKind::kInteger    ? H5T_NATIVE_INT64
                       : kind == CellKind::kUnsigned ? H5T_NATIVE_UINT64
                                                     : H5T_NATIVE_DOUBLE;
    return {H5Tcopy(type), H5Tclose, path};
  }

  Id make(hid_t group, const std::string& name) {
    const hsize_t none = 0;
    const hsize_t unlimited = H5S_UNLIMITED;
    const Id space(H5Screate_simple(1, &none, &unlimited), H5Sclose, path_);
    const Id layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, path_);
    require_done(H5Pset_chunk(layout, 1, &kBlockRows), path_);
    if (values_.kind != CellKind::kText) require_done(H5Pset_shuffle(layout), path_);
    require_done(H5Pset_deflate(layout, 1), path_);
    return {H5Dcreate2(group, name.c_str(), type_, space, H5P_DEFAULT, layout, H5P_DEFAULT),
            H5Dclose, path_};
  }

  const std::string& path_;
  HeldColumn values_;
  Id type_;
  Id set_;
  hsize_t rows_ = 0;
  hsize_t held_ = 0;
};

class Hdf5Sink : public TableSink {
 public:
  Hdf5Sink(hid_t file, const TopicTable& table, const std::string& path)
      : of_messages_(table.of_messages),
        group_(H5Gcreate2(file, table.name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
               H5Gclose, path) {
    put_attribute(group_, "topic", table.topic, path);
    put_attribute(group_, "type", table.type, path);
    const std::vector<ColumnHead> heads = column_heads(table, kLongestHdf5Name);
    columns_.reserve(heads.size());
    for (const ColumnHead& head : heads) columns_.emplace_back(group_, head, path);
  }

  void take(const TableRow& row) override {
    auto column = columns_.begin();
    for_each_cell(row, of_messages_, [&](const Cell& cell) { (column++)->take(cell); });
  }

  void finish() override {
    for (Column& column : columns_) column.write();
  }

 private:
  bool of_messages_;
  Id group_;
  std::vector<Column> columns_;
};

class Hdf5File : public TableFile {
 public:
  explicit Hdf5File(const std::string& path)
      : path_(path),
        pending_(path),
        file_(H5Fcreate(pending_.path().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose,
              path_) {}

  std::unique_ptr<TableSink> add(const TopicTable& table, std::uint64_t /*rows*/) override {
    return std::make_unique<Hdf5Sink>(file_, table, path_);
  }
  void close() override {
    require_done(H5Fflush(file_, H5F_SCOPE_GLOBAL), path_);
    require_done(file_.close(), path_);
  }
  void publish() override { pending_.publish(); }

 private:
  std::string path_;
  PendingFile pending_;
  Id file_;
};

}  // namespace

std::unique_ptr<TableFile> hdf5_tables(const std::string& path) {
  // Every file is closed here. At exit the library would write once more what a full disk refused.
  H5dont_atexit();
  // Failures are reported by return values; the library would also print its stack.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  return std::make_unique<Hdf5File>(path);
}

}  // namespace stillhand::recordings
