# The kernel's instruction-set copies: which there are, and how each is compiled.

# -ffp-contract=fast: fused multiply-add where the set has it. -Wno-psabi: GCC's notice that 64-byte vectors are passed
# differently with and without AVX-512; here every function with such an argument is inlined into its copy.
set(PLIANT_MPC_KERNEL_FLAGS -O2 -fno-math-errno -fno-trapping-math -ffp-contract=fast -fvisibility=hidden -Wno-psabi)
set(PLIANT_MPC_FLAGS_avx2 -mavx2 -mfma -mbmi2)
set(PLIANT_MPC_FLAGS_avx512 -mavx512f -mavx512vl -mavx512dq -mavx512bw -mavx2 -mfma -mbmi2)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
  set(PLIANT_MPC_ISAS sse2 avx2 avx512 CACHE STRING "Copies of the MPC kernel; avx512 needs avx2")
else()
  set(PLIANT_MPC_ISAS neon CACHE STRING "Copies of the MPC kernel")
endif()
set(PLIANT_MPC_KERNEL_SOURCE ${CMAKE_CURRENT_LIST_DIR}/kernel/engine.cpp)

# Two object libraries per instruction set: PREFIX_isa with eight lanes, PREFIX_isa_four with four. Their objects go to
# the variable named by RESULT, and what dispatch.cpp has to know about which there are to PLIANT_MPC_ISA_DEFINITIONS.
# Further arguments: flags.
function(pliant_mpc_kernel prefix result)
  set(objects)
  set(definitions)
  foreach(isa IN LISTS PLIANT_MPC_ISAS)
    foreach(copy ${isa} ${isa}_four)
      set(target ${prefix}_${copy})
      set(lanes 8)
      if(copy MATCHES "_four$")
        set(lanes 4)
      endif()
      add_library(${target} OBJECT ${PLIANT_MPC_KERNEL_SOURCE})
      target_compile_definitions(${target} PRIVATE PLIANT_ISA=${copy} PLIANT_LANES=${lanes})
      target_compile_options(${target} PRIVATE ${PLIANT_MPC_KERNEL_FLAGS} ${PLIANT_MPC_FLAGS_${isa}} ${ARGN})
      list(APPEND objects $<TARGET_OBJECTS:${target}>)
    endforeach()
    string(TOUPPER ${isa} name)
    list(APPEND definitions PLIANT_HAS_${name})
  endforeach()
  set(${result} ${objects} PARENT_SCOPE)
  set(PLIANT_MPC_ISA_DEFINITIONS ${definitions} PARENT_SCOPE)
endfunction()
