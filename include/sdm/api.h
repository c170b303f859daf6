/// The mark of the public API: all other symbols of a shared library are hidden.
#pragma once

#if defined(__GNUC__)
#define SDM_API __attribute__((visibility("default")))
#else
#define SDM_API
#endif
