/* What the library shows to its callers. */
#ifndef SKETCH_API_H
#define SKETCH_API_H

#include <stdint.h>

#if defined(_WIN32)
#define INK_API __declspec(dllexport)
#else
#define INK_API __attribute__((visibility("default")))
#endif

/* Functions that are mostly loops over numbers are compiled for wider registers as well, which the loader chooses where there
 * are such: the same operations in the same order, so the same bits. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__) &&                           \
    !defined(__SANITIZE_ADDRESS__)
#define INK_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define INK_WIDE
#endif

#endif
