// Cargo wants a library to have a source.
