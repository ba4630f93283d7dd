// The folder of an export: taken only when it is empty or may be replaced, and cleared again when the export fails.
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/system/file_bytes.hpp"

namespace pipeline {

/// Throws Error(kFile) for a folder that cannot be taken; `option` is how the user named it.
void refuse_folder(const std::filesystem::path& folder, bool force, const std::string& option);

/// What was written, taken away again unless `keep` is called.
class ExportFolder {
 public:
  explicit ExportFolder(const std::filesystem::path& path) : made_(path), folder_(open_folder(path)) {}
  ~ExportFolder() {
    for (const std::string& file : files_) remove_regular(folder(), file);
  }
  ExportFolder(const ExportFolder&) = delete;
  ExportFolder& operator=(const ExportFolder&) = delete;

  int folder() const { return folder_.number(); }
  void file(const std::string& name, std::string_view text) {
    put_file(folder(), name, {text});
    files_.push_back(name);
  }
  void keep() {
    files_.clear();
    made_.keep();
  }

 private:
  MadeFolders made_;
  Descriptor folder_;
  std::vector<std::string> files_;
};

}  // namespace pipeline
