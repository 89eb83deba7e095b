// What the leak sanitizer may overlook: drivers keep tables until the process ends, and some are unreachable
// by then. Unused without the sanitizer.

extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libEGL\n"
           "leak:libEGL_mesa\n"
           "leak:libOSMesa\n"
           "leak:libgallium\n"
           "leak:libglapi\n"
           "leak:libLLVM\n"
           "leak:swrast_dri\n"
           "leak:_dri.so\n";
}
