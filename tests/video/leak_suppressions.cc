// Read by the leak checker of the sanitize build; otherwise unused. Both libraries keep some memory
// to the end of the program on purpose: fontconfig its cache of fonts, OSMesa its screen.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libfontconfig.so\nleak:libOSMesa.so\nleak:libLLVM\n";
}
