// The implementations of two header-only libraries, which are not ours to check.
#ifndef __clang_analyzer__
#define STB_TRUETYPE_IMPLEMENTATION
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>
#include <stb/stb_truetype.h>
#endif
