/// \file data_directory.h
/// Where kernels and scenes are looked up by name.
#ifndef SPHVERIFY_CORE_DATA_DIRECTORY_H
#define SPHVERIFY_CORE_DATA_DIRECTORY_H

/// The data directory: `option` when given, then the environment's SPHVERIFY_DATA, then the source
/// tree's when the program runs from its build folder, else the installed one. Static storage.
const char *sphv_data_directory(const char *option);

#endif
