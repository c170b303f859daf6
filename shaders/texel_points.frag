#version 450 core
// Writes nothing but the stencil.

void main() {}
