// tinygltf's implementation. It is compiled here, not taken from its shared library: Debian's libdraco holds another one under the same
// names, and whichever the loader finds first would answer for both.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
