// Launches one small kernel that is wrong in the way its argument names; self_test.sh runs it to see
// that each way is noticed. Uses OpenCL alone, so that no care taken by the library can hide a fault.
#ifndef CL_TARGET_OPENCL_VERSION
#define CL_TARGET_OPENCL_VERSION 120
#endif
#include <CL/cl.h>

#include <cstdio>
#include <cstring>

namespace {

const char* const source = R"(
kernel void right(global uint* out) { out[get_global_id(0)] = (uint)get_global_id(0); }
kernel void out_of_bounds_read(global uint* out) {
    const size_t i = get_global_id(0);
    const uint next = out[i + 1];
    if (next == 12345u) out[i] = 0;
}
kernel void out_of_bounds_write(global uint* out) { out[get_global_id(0) + 1] = 1; }
kernel void out_of_bounds_local(global uint* out) {
    local uint shared[32];
    shared[get_local_id(0)] = 1;
    barrier(CLK_LOCAL_MEM_FENCE);
    out[get_global_id(0)] = shared[get_local_id(0) / 2];
}
kernel void race_global(global uint* out) { out[0] = (uint)get_global_id(0); }
kernel void race_local(global uint* out) {
    local uint shared[64];
    shared[get_local_id(0)] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    shared[get_local_id(0)] = (uint)get_local_id(0);
    out[get_global_id(0)] = shared[63 - get_local_id(0)];
}
kernel void uninitialised(global uint* out) {
    local uint shared[64];
    if (get_local_id(0) > 0) shared[get_local_id(0)] = 1;
    barrier(CLK_LOCAL_MEM_FENCE);
    out[get_global_id(0)] = shared[0] == 7u ? 1u : 2u;
}
)";

constexpr std::size_t items = 64;

bool ok(cl_int status, const char* call) {
    if (status != CL_SUCCESS) std::fprintf(stderr, "faulty_kernel: %s failed with status %d\n", call, status);
    return status == CL_SUCCESS;
}

// What was made is left to the end of the process.
bool launch(const char* name) {
    cl_platform_id platform = nullptr;
    cl_device_id device = nullptr;
    cl_int status = clGetPlatformIDs(1, &platform, nullptr);
    if (!ok(status, "clGetPlatformIDs")) return false;
    if (!ok(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, nullptr), "clGetDeviceIDs")) return false;
    cl_context context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status);
    if (!ok(status, "clCreateContext")) return false;
    cl_command_queue queue = clCreateCommandQueue(context, device, 0, &status);
    if (!ok(status, "clCreateCommandQueue")) return false;
    const char* text = source;
    cl_program program = clCreateProgramWithSource(context, 1, &text, nullptr, &status);
    if (!ok(status, "clCreateProgramWithSource")) return false;
    if (!ok(clBuildProgram(program, 1, &device, "", nullptr, nullptr), "clBuildProgram")) return false;
    cl_kernel kernel = clCreateKernel(program, name, &status);
    if (!ok(status, "clCreateKernel")) return false;
    cl_uint zeros[items] = {};
    cl_mem out = clCreateBuffer(context, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, sizeof zeros, zeros, &status);
    if (!ok(status, "clCreateBuffer")) return false;
    if (!ok(clSetKernelArg(kernel, 0, sizeof(cl_mem), &out), "clSetKernelArg")) return false;
    status = clEnqueueNDRangeKernel(queue, kernel, 1, nullptr, &items, &items, 0, nullptr, nullptr);
    return ok(status, "clEnqueueNDRangeKernel") && ok(clFinish(queue), "clFinish");
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const bool fails = std::strcmp(argv[1], "program_fails") == 0;
    if (!launch(fails ? "right" : argv[1])) return 1;
    std::puts("launched");
    return fails ? 7 : 0;
}
