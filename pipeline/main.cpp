#include "pipeline/cli.hpp"

int main(int argc, char** argv) { return pipeline::command_line(argc, argv); }
