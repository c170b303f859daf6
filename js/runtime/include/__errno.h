// Of wasi-libc, which is compiled without threads: threads share its errno, which nothing here depends on.
#ifndef __wasilibc___errno_h
#define __wasilibc___errno_h

#ifdef __cplusplus
extern "C" {
#endif
extern int errno;
#ifdef __cplusplus
}
#endif
#define errno errno

#endif
