# SPDX-License-Identifier: Apache-2.0
# Run while building (CMakeLists.txt): uPlot at its pinned version and checksum, into PAGE.
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json DESTINATION ${WORK})
execute_process(COMMAND ${NPM} ci --ignore-scripts --no-audit --no-fund WORKING_DIRECTORY ${WORK}
                TIMEOUT 120 RESULT_VARIABLE failed OUTPUT_QUIET ERROR_VARIABLE told)
if(failed)
  string(STRIP "${told}" told)
  string(REGEX REPLACE "\n.*" "" told "${told}")
  message(WARNING "npm brings no uPlot (${told}): stillhand dashboard has no page")
  return()
endif()
set(uplot ${WORK}/node_modules/uplot)
file(COPY ${uplot}/dist/uPlot.min.css DESTINATION ${PAGE})
file(COPY_FILE ${uplot}/LICENSE ${PAGE}/uPlot.LICENSE)
# Last: its presence means that the others are there.  Its time is the build's, not the package's.
file(COPY_FILE ${uplot}/dist/uPlot.esm.js ${PAGE}/uPlot.esm.js)
file(TOUCH ${PAGE}/uPlot.esm.js)
