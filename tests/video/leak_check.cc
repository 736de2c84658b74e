/// AddressSanitizer asks for its options here. Mesa's threads may still be ending when the program
/// of a test ends, and the leak checker, which looks into every thread, then sometimes fails itself
/// ("Tracer caught signal 11"). What is lost in drawing shows where whole commands make videos.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }
