#include "pipeline/commands/export_folder.hpp"

#include "pipeline/terminal/error.hpp"

namespace pipeline {
namespace fs = std::filesystem;

void refuse_folder(const fs::path& folder, bool force, const std::string& option) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  const std::string place = folder.string();
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) throw Error(kFile, place + ": is not a folder; choose another " + option);
  const bool empty = fs::is_empty(folder, error);
  if (error) throw Error(kFile, place + ": cannot be read (" + error.message() + ")");
  if (!empty && !force)
    throw Error(kFile, place + ": is not empty; --force replaces an earlier export in it, or choose another " + option);
}

}  // namespace pipeline
