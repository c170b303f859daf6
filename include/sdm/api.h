/// Export macro of the public API. All other symbols of a shared library are hidden.
#pragma once

#if defined(__GNUC__)
#define SDM_API __attribute__((visibility("default")))
#else
#define SDM_API
#endif
