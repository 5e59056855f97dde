/* Which functions, with which arguments, the library has: counted up with every change of them, here and in
 * sketch/library.py. */
#include "fit.h"

INK_API int32_t ink_abi(void) { return 39; }
