/* bcryptprimitives.dll with its one function that Rust's standard library calls. Windows has had this DLL since
 * Windows 7; Wine before 8.8 has not, so the tests of the Windows package build it. It is not a part of the package. */
#include <windows.h>

BOOLEAN NTAPI SystemFunction036(PVOID buffer, ULONG size); /* RtlGenRandom of advapi32.dll */

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE buffer, SIZE_T size) {
    return SystemFunction036(buffer, (ULONG)size);
}
