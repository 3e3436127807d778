/* What kernels in a library need of numba's run time: memory that is counted (for the few that allocate; what is
 * counted down to nothing is freed), and which of the instruction sets that the library has the processor knows. */

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#define VISIBLE __declspec(dllexport)
#else
#define VISIBLE __attribute__((visibility("default")))
#endif

/* numba/core/runtime/nrt.cpp: machine code reads `data`, and counts in `count`. */
typedef struct {
    size_t count;
    void (*destroy)(void *data, size_t size, void *about);
    void *about;
    void *data;
    size_t size;
    void *allocator;
} MemInfo;

void *NRT_Allocate(size_t size) { return malloc(size); }

void NRT_Free(void *memory) { free(memory); }

MemInfo *NRT_MemInfo_alloc_aligned(size_t size, unsigned align) {
    char *memory = malloc(sizeof(MemInfo) + size + align);
    if (memory == NULL)
        return NULL;
    MemInfo *info = (MemInfo *)memory;
    size_t start = (size_t)(memory + sizeof(MemInfo));
    memset(info, 0, sizeof(MemInfo));
    info->count = 1;
    info->data = memory + sizeof(MemInfo) + (align - start % align) % align;
    info->size = size;
    return info;
}

MemInfo *NRT_MemInfo_alloc(size_t size) { return NRT_MemInfo_alloc_aligned(size, 16); }

void NRT_MemInfo_call_dtor(MemInfo *info) {
    if (info->destroy != NULL)
        info->destroy(info->data, info->size, info->about);
    free(info);
}

/* Memory of a list, which may move. */
static void destroy_list(void *data, size_t size, void *about) {
    if (about != NULL)
        ((void (*)(void *, size_t, void *))about)(data, size, NULL);
    free(data);
}

MemInfo *NRT_MemInfo_new_varsize_dtor(size_t size, void *about) {
    MemInfo *info = calloc(1, sizeof(MemInfo));
    if (info == NULL)
        return NULL;
    info->data = malloc(size);
    if (info->data == NULL) {
        free(info);
        return NULL;
    }
    info->count = 1;
    info->destroy = destroy_list;
    info->about = about;
    info->size = size;
    return info;
}

void *NRT_MemInfo_varsize_realloc(MemInfo *info, size_t size) {
    void *data = realloc(info->data, size);
    if (data == NULL)
        return NULL;
    info->data = data;
    info->size = size;
    return data;
}

/* Another shape of an array, without a copy: of one whose items lie one after the other. 0: there is none. */
int numba_attempt_nocopy_reshape(ptrdiff_t nd, const ptrdiff_t *shape, const ptrdiff_t *strides, ptrdiff_t new_nd,
                                 const ptrdiff_t *new_shape, ptrdiff_t *new_strides, ptrdiff_t item, int fortran) {
    ptrdiff_t size = item, i;
    if (fortran)
        return 0;
    for (i = nd - 1; i >= 0; i--) {
        if (shape[i] != 1 && strides[i] != size)
            return 0;
        size *= shape[i];
    }
    size = item;
    for (i = new_nd - 1; i >= 0; i--) {
        new_strides[i] = size;
        size *= new_shape[i];
    }
    return 1;
}

/* Where an exception has arguments, numba adds a function that makes objects of Python's of them, which may fail. The
 * library has no way in that calls it, and knows no Python: these are its own. */
void *PyExc_RuntimeError;

void PyErr_SetString(void *kind, const char *text) {
    (void)kind;
    (void)text;
}

/* An array that a kernel has given to Python has been copied: count it down. Only that thread has it. */
VISIBLE void rigidarea_release(MemInfo *info) {
    if (--info->count == 0)
        NRT_MemInfo_call_dtor(info);
}

/* 0: what all processors of this kind have; 1: what gcc and LLVM call x86-64-v3. */
#ifdef __x86_64__
#include <cpuid.h>

VISIBLE int rigidarea_level(void) {
    const unsigned v3_1c = bit_FMA | bit_MOVBE | bit_OSXSAVE | bit_AVX | bit_F16C;
    const unsigned v3_7b = bit_BMI | bit_AVX2 | bit_BMI2;
    unsigned a, b, c, d, low, high;
    if (!__get_cpuid(1, &a, &b, &c, &d) || (c & v3_1c) != v3_1c)
        return 0;
    __asm__("xgetbv" : "=a"(low), "=d"(high) : "c"(0));
    if ((low & 6) != 6) /* whether the system keeps the wider registers */
        return 0;
    if (!__get_cpuid_count(7, 0, &a, &b, &c, &d) || (b & v3_7b) != v3_7b)
        return 0;
    return __get_cpuid(0x80000001, &a, &b, &c, &d) && (c & bit_LZCNT) != 0;
}
#else
VISIBLE int rigidarea_level(void) { return 0; }
#endif

#ifdef _WIN32
#include <windows.h>
/* The processor time of this thread. */
int clock_gettime(int clock, long long *at) {
    FILETIME made, ended, kernel, user;
    (void)clock;
    if (!GetThreadTimes(GetCurrentThread(), &made, &ended, &kernel, &user))
        return -1;
    unsigned long long ticks = (((unsigned long long)kernel.dwHighDateTime << 32) | kernel.dwLowDateTime) +
                               (((unsigned long long)user.dwHighDateTime << 32) | user.dwLowDateTime);
    at[0] = (long long)(ticks / 10000000);
    at[1] = (long long)(ticks % 10000000) * 100;
    return 0;
}
#endif
