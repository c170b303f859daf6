// The implementation of tinygltf, where it is installed as a header only.
#define TINYGLTF_IMPLEMENTATION
#include <tiny_gltf.h>
