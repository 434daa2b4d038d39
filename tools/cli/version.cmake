# cmake -P: TEMPLATE -> OUTPUT with VERSION, BUILD and the commit of SOURCE ("unknown" outside a repository).
set(COMMIT unknown)
if(GIT)
  execute_process(COMMAND ${GIT} -C ${SOURCE} describe --always --dirty --abbrev=12 OUTPUT_VARIABLE answer RESULT_VARIABLE failed
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  if(NOT failed)
    set(COMMIT ${answer})
  endif()
endif()
configure_file(${TEMPLATE} ${OUTPUT} @ONLY)
