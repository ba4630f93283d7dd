#include "pipeline/commands/cli.hpp"
#include "pipeline/system/file_bytes.hpp"

int main(int argc, char** argv) {
  pipeline::open_standard_descriptors();
  return pipeline::command_line(argc, argv);
}
