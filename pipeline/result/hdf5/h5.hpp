// A thin wrapper over HDF5's C interface: identifiers are owned, a failed call names the action and HDF5's own reason.
// Calls stay the C ones. Included by store.cpp only.
#pragma once
#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace pipeline::h5 {

/// A call of HDF5 failed.
class Failure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Keeps HDF5 from printing its error stack; what failed is in the exceptions.
inline void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

/// The innermost description on HDF5's error stack, with a leading space and in brackets; empty when there is none.
inline std::string reason() {
  std::string text;
  const auto keep_last = [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
    if (error->desc && *error->desc) *static_cast<std::string*>(out) = error->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, keep_last, &text);
  return text.empty() ? text : " (" + text + ")";
}

/// Whether the last call failed for want of memory: that is nothing wrong with a file. zlib's want of it only errno
/// tells, which must be 0 when a file is opened.
inline bool out_of_memory() {
  bool found = errno == ENOMEM;
  const auto look = [](unsigned, const H5E_error2_t* error, void* out) -> herr_t {
    if (error->maj_num == H5E_RESOURCE && error->min_num == H5E_NOSPACE) *static_cast<bool*>(out) = true;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_DOWNWARD, look, &found);
  return found;
}

/// Throws Failure when a call's result is negative, or std::bad_alloc.
template <typename Code>
Code check(Code code, const std::string& what) {
  if (code < 0 && out_of_memory()) throw std::bad_alloc();
  if (code < 0) throw Failure("HDF5 could not " + what + reason());
  return code;
}

/// Owns an identifier that `Close` closes.
template <herr_t (*Close)(hid_t)>
class Handle {
 public:
  Handle(hid_t id, const std::string& what) : id_(check(id, what)) {}
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&&) = delete;
  ~Handle() {
    if (id_ >= 0) Close(id_);
  }

  hid_t id() const { return id_; }

 private:
  hid_t id_;
};
using File = Handle<H5Fclose>;
using Group = Handle<H5Gclose>;
using Dataset = Handle<H5Dclose>;
using Attribute = Handle<H5Aclose>;
using Space = Handle<H5Sclose>;
using Type = Handle<H5Tclose>;
using Properties = Handle<H5Pclose>;

/// Variable-length UTF-8, the only text that h5py gives back as text.
inline Type text_type() {
  Type type(H5Tcopy(H5T_C_S1), "make the type of texts");
  check(H5Tset_size(type.id(), H5T_VARIABLE), "make texts of variable length");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "make texts UTF-8");
  return type;
}

inline Space scalar() { return {H5Screate(H5S_SCALAR), "make a scalar"}; }

using Scalar = std::variant<std::string, std::int64_t, double, std::uint8_t>;

/// Gives an object a scalar attribute.
inline void write_attribute(hid_t object, const std::string& name, const Scalar& value) {
  const auto write = [&](hid_t type, const void* data) {
    const Space space = scalar();
    const Attribute attribute(H5Acreate2(object, name.c_str(), type, space.id(), H5P_DEFAULT, H5P_DEFAULT),
                              "make attribute " + name);
    check(H5Awrite(attribute.id(), type, data), "write attribute " + name);
  };
  if (const auto* text = std::get_if<std::string>(&value)) {
    const char* data = text->c_str();
    write(text_type().id(), &data);
  } else if (const auto* integer = std::get_if<std::int64_t>(&value)) {
    write(H5T_STD_I64LE, integer);
  } else if (const auto* real = std::get_if<double>(&value)) {
    write(H5T_IEEE_F64LE, real);
  } else {
    write(H5T_STD_U8LE, &std::get<std::uint8_t>(value));
  }
}

/// The scalar attribute of the object at `path`, converted to T: std::string, std::int64_t, double or std::uint8_t.
template <typename T>
T read_attribute(hid_t file, const std::string& path, const std::string& name) {
  const std::string what = "read attribute " + name + " of " + path;
  const Attribute attribute(H5Aopen_by_name(file, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), what);
  const Space space(H5Aget_space(attribute.id()), what);
  const Type type(H5Aget_type(attribute.id()), what);
  constexpr bool text = std::is_same_v<T, std::string>;
  const H5T_class_t wanted = text ? H5T_STRING : std::is_same_v<T, double> ? H5T_FLOAT : H5T_INTEGER;
  if (H5Sget_simple_extent_npoints(space.id()) != 1 || H5Tget_class(type.id()) != wanted ||
      (text && H5Tis_variable_str(type.id()) <= 0))
    throw Failure("HDF5 could not " + what + ": it has another type");
  if constexpr (std::is_same_v<T, std::string>) {
    char* data = nullptr;
    check(H5Aread(attribute.id(), text_type().id(), &data), what);
    std::string out = data ? data : "";
    H5free_memory(data);
    return out;
  } else {
    T out{};
    const hid_t memory = std::is_same_v<T, double>         ? H5T_NATIVE_DOUBLE
                         : std::is_same_v<T, std::int64_t> ? H5T_NATIVE_INT64
                                                           : H5T_NATIVE_UINT8;
    check(H5Aread(attribute.id(), memory, &out), what);
    return out;
  }
}

/// Whether there is a link at `path`; every part of it before the last must exist.
inline bool exists(hid_t file, const std::string& path) {
  return check(H5Lexists(file, path.c_str(), H5P_DEFAULT), "look for " + path) > 0;
}

/// Throws Failure unless every link is a hard one, and groups are nested no deeper than ours, tenfold. No link to
/// another place is followed for that: one to another file may lead to what never answers, and soft ones in circles.
inline void check_links(hid_t file) {
  constexpr int kMostDepth = 30;  // ours: /meshes/<name>/vertices
  struct Visit {
    std::string flaw;
  } visit;
  const auto look = [](hid_t, const char* path, const H5L_info_t* info, void* out) -> herr_t {
    int depth = 1;
    for (const char* c = path; *c; ++c) depth += *c == '/';
    const bool deep = depth > kMostDepth;
    if (info->type == H5L_TYPE_HARD && !deep) return 0;
    const char* what = deep                          ? ": is nested too deep"
                       : info->type == H5L_TYPE_SOFT ? ": is a soft link; a result has none"
                                                     : ": is a link to another file; a result has none";
    static_cast<Visit*>(out)->flaw.append("/").append(path, std::min<std::size_t>(std::strlen(path), 200)).append(what);
    return 1;
  };
  const herr_t ended = H5Lvisit(file, H5_INDEX_NAME, H5_ITER_NATIVE, look, &visit);
  if (!visit.flaw.empty()) throw Failure(visit.flaw);
  check(ended, "list the file");
}

/// The names of the links in a group of at most `most`, in the order in which they were made.
inline std::vector<std::string> names_in(hid_t file, const std::string& path, std::uint64_t most) {
  const Group group(H5Gopen2(file, path.c_str(), H5P_DEFAULT), "open " + path);
  H5G_info_t info;
  check(H5Gget_info(group.id(), &info), "count " + path);
  if (info.nlinks > most)
    throw Failure(path + ": has " + std::to_string(info.nlinks) + " entries, at most " + std::to_string(most) +
                  " make sense");
  std::vector<std::string> names;
  const auto keep = [](hid_t, const char* name, const H5L_info_t*, void* out) -> herr_t {
    static_cast<std::vector<std::string>*>(out)->emplace_back(name);
    return 0;
  };
  check(H5Literate(group.id(), H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, keep, &names), "list " + path);
  return names;
}

}  // namespace pipeline::h5
