// Steps of a result as files that ParaView opens: one VTP (VTK's XML PolyData) per step and a .pvd index in time.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "pipeline/result/result.hpp"
#include "pipeline/terminal/step_range.hpp"

namespace pipeline {

/// The VTP of a step (README, "ParaView"): the world vertices of all bodies that are born, the very doubles by which
/// the truth was decided; their triangles, with data per triangle: `body` (its number), `truth_hits` (pairs of the body
/// that score), `false_positive_<label>` and `false_negative_<label>` (pairs of the body); and as field data TimeValue
/// (s), `step`, and `name` of every body by its number.
std::string vtp(const Result& result, std::size_t step);

/// `path` without folder and extension, whatever XML or a file system could stumble over made '_'.
std::string export_name(const std::filesystem::path& path);

struct ExportOptions {
  std::filesystem::path folder;  // made when it does not exist
  std::string name;              // <name>.pvd is the index, <name>_000420.vtp a step
  StepRange steps;
  bool force = false;  // an earlier export of this name is removed; else a folder with anything in it is refused
  bool quiet = false;
};

/// Bytes that the export will take on the disk, about: the largest step is made in memory. Throws Error: kFile for a
/// folder that cannot be taken, kInput when the disk is too small.
std::uint64_t export_bytes(const Result& result, const ExportOptions& options);

/// Writes the files, the index last, and returns the index's path. When it fails or is interrupted nothing that it
/// wrote stays. Throws Error: kFile for the folder and a full disk, kInput when the disk is too small, kInterrupted.
std::filesystem::path write_vtk(const Result& result, const ExportOptions& options);

}  // namespace pipeline
