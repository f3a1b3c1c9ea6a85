// SPDX-License-Identifier: Apache-2.0
#include "identification/core/identifier.hpp"

#include "identification/core/arx.hpp"
#include "identification/core/output_error.hpp"
#include "identification/core/paper_preprocessing.hpp"

namespace stillhand::identification {

FeedthroughModel identify(const Record& recorded, const Config& config) {
  validate(config, "identification");
  const Record record = preprocessed(recorded);
  const ArxFit arx = fit_arx(record, static_cast<int>(config.order));
  FeedthroughModel out;
  out.fit = arx.model;
  out.heldout = arx.heldout;
  out.condition_number = arx.condition_number;
  // A free run that diverges can't cancel anything: the refinement keeps stability.
  if (config.refine || !arx.stable) {
    const OutputErrorFit refined = refine_output_error(record, arx.model);
    out.fit = refined.model;
    out.heldout = refined.heldout;
    out.refined = true;
  }
  ConversionBand band;
  band.max_error = config.max_conversion_error;
  const RateConversion conversion = to_control_rate(out.fit, band);
  out.control = conversion.model;
  out.conversion_error = conversion.max_error;
  return out;
}

}  // namespace stillhand::identification
