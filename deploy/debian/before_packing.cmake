# SPDX-License-Identifier: Apache-2.0
# CPack runs this. It sets the permissions that installation takes from the builder's umask, and strips the static
# libraries, which CPack's own strip skips (their debug information would be 400 MB).
file(CHMOD_RECURSE ${CPACK_TEMPORARY_INSTALL_DIRECTORY} DIRECTORY_PERMISSIONS
     OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
file(GLOB_RECURSE archives ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*.a)
execute_process(COMMAND ${CPACK_STRIP_PROGRAM} --strip-debug --enable-deterministic-archives ${archives}
                COMMAND_ERROR_IS_FATAL ANY)
