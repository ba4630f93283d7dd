// The seal of a result: one line of text after the end of the HDF5 data, over every byte before it.
//
//   "\ncollision benchmark result, seal 1: XXH3-128 <32 hexadecimal digits> of <20 decimal digits> bytes\n"
//
// HDF5 and whatever stands on it read a file by the length in its head and do not see what follows: h5py, xarray (which
// finds its engine by the first bytes), h5dump, h5ls, h5stat, h5diff and `file` read a sealed file as any other. HDF5's
// own place for foreign bytes, a user block at the front, was tried too: xarray no longer knew the file without
// `engine=`. Whatever writes into the file, or copies it anew as h5repack does, loses or breaks the seal; that there
// must be one says the root's attribute `sealed`, which results had not before seals were made.
//
// It finds damage, also to times and attributes, before the HDF5 library sees a byte: 1.10.8 loops for ever or crashes
// on some damaged files. It is no signature: whoever changes a file on purpose can make another.
#pragma once
#include <cstddef>
#include <span>
#include <string>

#include "pipeline/system/input_file.hpp"

namespace pipeline {

enum class Seal { none, holds, differs, unknown };  // unknown: of a later form

/// The seal of the bytes of an HDF5 file.
std::string seal_of(std::span<const std::byte> bytes);

/// Whether the file ends with its seal. Throws Error(kFile) when it cannot be read; `path` is its name.
Seal seal_of(const InputFile& file, const std::filesystem::path& path);

}  // namespace pipeline
