#version 450 core
// Writes only the stencil.

void main() {}
