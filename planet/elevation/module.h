#pragma once
// Shared modules opened at run time. GDAL and OpenImageIO pull in hundreds of libraries (tens of milliseconds and up to
// 120 MB a process), so the code that needs them is in modules of its own, opened when a file must be read. The library
// itself builds and runs without either.

namespace planet {

/// Opens a module once and looks a symbol up. Searched in this order: the folder of the running executable, the install
/// folder given at build time, the folders (separated by ':') in the environment variable OCTAGLOBE_MODULES.
/// Throws Error if there is no such module, or it or a library it needs cannot be loaded. Safe from several threads.
/// @param name  e.g. "octaglobe_gdal"
/// @param what  what it is for, e.g. "reading elevation files"
void* module_symbol(const char* name, const char* symbol, const char* what);

/// Whether there is such a module in one of those folders.
bool has_module(const char* name);

}  // namespace planet
