//! The C boundary: the only place with `extern "C"` and raw pointers.
