/* What the library shows to its callers. */
#ifndef SKETCH_API_H
#define SKETCH_API_H

#if defined(_WIN32)
#define INK_API __declspec(dllexport)
#else
#define INK_API __attribute__((visibility("default")))
#endif

#endif
