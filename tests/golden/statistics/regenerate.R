# SPDX-License-Identifier: Apache-2.0
# Writes the three CSV files from stated seeds, reads them back, and writes expected.hpp; see ORIGIN.md.

# One row an observation, in the order of ManovaLayout; decimals are kept few so that the text is the number.
write_trials <- function(file, seed, subjects, conditions, replicates, centre, effect, between, within, noise) {
  set.seed(seed, kind = "Mersenne-Twister", normal.kind = "Inversion", sample.kind = "Rejection")
  rows <- expand.grid(replicate = seq_len(replicates), condition = seq_len(conditions), subject = seq_len(subjects))
  metrics <- length(centre)
  person <- matrix(rnorm(subjects * metrics), subjects) %*% diag(between, metrics)
  # Neighbouring metrics share half of their noise, so that residuals are correlated.
  raw <- matrix(noise(nrow(rows) * metrics), nrow(rows))
  shared <- raw + 0.5 * raw[, c(metrics, seq_len(metrics - 1)), drop = FALSE]
  y <- matrix(centre, nrow(rows), metrics, byrow = TRUE) + effect[rows$condition, , drop = FALSE] +
    person[rows$subject, , drop = FALSE] + shared %*% diag(within, metrics)
  colnames(y) <- paste0("metric_", seq_len(metrics))
  write.csv(cbind(rows[c("subject", "condition", "replicate")], round(y, 5)), file, row.names = FALSE, quote = FALSE)
}

# Like the study: 12 subjects, 3 conditions, a trial a cell, three metrics, moderate effects.
write_trials("well_behaved.csv", 20110101, 12, 3, 1, c(6, 0.4, 0.2),
             rbind(c(0, 0, 0), c(0.9, -0.04, -0.02), c(0.4, -0.02, 0.004)), c(0.8, 0.05, 0.03), c(0.7, 0.04, 0.02), rnorm)
# Effects so strong that p falls to 1e-20 and below.
write_trials("strong_effects.csv", 20110102, 20, 3, 1, c(9.62, 0.23, 0.1),
             rbind(c(-5.58, 0.25, 0.15), c(0, 0, 0), c(-2.61, 0.08, 0.04)), c(0.9, 0.03, 0.01), c(0.2, 0.012, 0.006), rnorm)
# 9 subjects, 6 conditions, 3 replicates, five metrics with heavy tails (t of 3 degrees of freedom): outliers.
write_trials("replicated.csv", 20110103, 9, 6, 3, c(5, 0, -3, 100, 0.01),
             outer(0:5, c(0.3, -0.2, 0.1, 4, 0.001)), c(1, 0.5, 1, 10, 0.004), c(1, 0.8, 2, 12, 0.003), function(n) rt(n, 3))

# The shortest text that reads back as the same double.
number <- function(x) {
  text <- sprintf("%.15g", x)
  for (digits in 16:17) text <- ifelse(as.numeric(text) == x, text, sprintf("%.*g", digits, x))
  text
}
row_text <- function(x) paste0("{", paste(number(unlist(x)), collapse = ", "), "}")
out <- character(0)
say <- function(...) out <<- c(out, paste0(...))
array <- function(name, values, a_line = length(values)) {
  say("inline constexpr double ", name, "[] = {")
  for (first in seq(1, length(values), a_line))
    say("    ", paste(number(values[first:(first + a_line - 1)]), collapse = ", "), ",")
  say("};")
}
table_of <- function(type, name, rows) {
  say("inline constexpr ", type, " ", name, "[] = {")
  for (row in rows) say("    ", row_text(row), ",")
  say("};")
}

trials <- list(WellBehaved = read.csv("well_behaved.csv"), StrongEffects = read.csv("strong_effects.csv"),
               Replicated = read.csv("replicated.csv"))
metrics_of <- function(set) as.matrix(set[, -(1:3)])

say("// SPDX-License-Identifier: Apache-2.0")
say("// Written by regenerate.R with ", R.version.string, "; see ORIGIN.md.")
say("#pragma once")
say("")
say("#include <optional>")
say("")
say("// One result a line:")
say("// clang-format off")
say("namespace stillhand::golden::statistics {")
# t-tests: t.test; dz and its correction by their formulas, with R's log gamma.
say("struct TTestRow {")
say("  int set, first, second, metric; double confidence, mean, deviation, t, degrees, p, low, high, dz, gz;")
say("};")
effect_sizes <- function(d) {
  dz <- mean(d) / sd(d)
  v <- length(d) - 1
  c(dz, dz * exp(lgamma(v / 2) - lgamma((v - 1) / 2)) / sqrt(v / 2))
}
t_row <- function(set, a, b, metric, level) {
  s <- trials[[set]]
  y <- function(condition) metrics_of(s)[s$condition == condition & s$replicate == 1, metric]
  r <- t.test(y(a), y(b), paired = TRUE, conf.level = level)
  d <- y(a) - y(b)
  c(set - 1, a - 1, b - 1, metric - 1, level, mean(d), sd(d), r$statistic, r$parameter, r$p.value, r$conf.int, effect_sizes(d))
}
rows <- list()
for (set in 1:2) for (pair in list(c(1, 2), c(2, 3), c(3, 1))) for (metric in 1:3)
  rows <- c(rows, list(t_row(set, pair[1], pair[2], metric, if (metric == 2) 0.99 else 0.95)))
table_of("TTestRow", "kPaired", rows)
say("// One-sample: metric, reference, from the confidence on as above; interval of mean - reference.")
say("struct OneSampleRow {")
say("  int metric; double reference, confidence, mean, deviation, t, degrees, p, low, high, dz, gz;")
say("};")
rows <- lapply(list(c(1, 6), c(2, 0.4), c(3, 0)), function(k) {
  x <- metrics_of(trials[[1]])[, k[1]]
  r <- t.test(x, mu = k[2], conf.level = 0.9)
  d <- x - k[2]
  c(k[1] - 1, k[2], 0.9, mean(d), sd(d), r$statistic, r$parameter, r$p.value, r$conf.int - k[2], effect_sizes(d))
})
table_of("OneSampleRow", "kOneSample", rows)

# MANOVA: summary.manova for Wilks and Pillai; one metric alone by anova(lm), where Lambda = SSE / (SSE + SSH) and
# Pillai's trace its complement, with one F for both.
say("struct EffectRow {")
say("  double lambda, wilks_f, wilks_1, wilks_2, wilks_p, trace, pillai_f, pillai_1, pillai_2, pillai_p;")
say("};")
say("struct ManovaRow {")
say("  int set, subjects, conditions, replicates, metrics; double error_df; EffectRow condition, subject;")
say("  std::optional<EffectRow> interaction;")
say("};")
effect_text <- function(y, formula, term) {
  if (ncol(y) == 1) {
    a <- anova(lm(formula))
    h <- a[term, "Sum Sq"]
    e <- a["Residuals", "Sum Sq"]
    f <- c(a[term, "F value"], a[term, "Df"], a["Residuals", "Df"], a[term, "Pr(>F)"])
    return(row_text(c(e / (e + h), f, h / (e + h), f)))
  }
  w <- summary(manova(formula), test = "Wilks")$stats[term, ]
  p <- summary(manova(formula), test = "Pillai")$stats[term, ]
  row_text(c(w[2:6], p[2:6]))
}
say("inline constexpr ManovaRow kManova[] = {")
manova_row <- function(set, subjects, conditions, replicates, metrics) {
  s <- trials[[set]]
  s <- s[s$subject <= subjects & s$condition <= conditions & s$replicate <= replicates, ]
  y <- metrics_of(s)[, seq_len(metrics), drop = FALSE]
  condition <- factor(s$condition)
  subject <- factor(s$subject)
  formula <- if (replicates > 1) y ~ condition * subject else y ~ condition + subject
  environment(formula) <- environment()
  say("    {", paste(c(set - 1, subjects, conditions, replicates, metrics), collapse = ", "), ", ", lm(formula)$df.residual, ", ",
      effect_text(y, formula, "condition"), ", ", effect_text(y, formula, "subject"), ", ",
      if (replicates > 1) paste0("EffectRow", effect_text(y, formula, "condition:subject")) else "std::nullopt", "},")
}
for (metrics in 1:3) manova_row(1, 12, 3, 1, metrics)
for (metrics in 1:3) manova_row(2, 20, 3, 1, metrics)
for (conditions in 2:6) for (metrics in 1:5) for (replicates in c(1, 3)) manova_row(3, 9, conditions, replicates, metrics)
say("};")

# Describing: each metric of each set; quantile type 7, intervals of t.test, quartiles.
say("struct DescriptionRow {")
say("  int set, metric; double mean, deviation, median, low_95, high_95, low_99, high_99; double quantiles[7];")
say("  double lower_quartile, upper_quartile;")
say("};")
array("kProbabilities", c(0, 0.05, 0.25, 1 / 3, 0.6, 0.975, 1))
say("inline constexpr DescriptionRow kDescriptions[] = {")
for (set in 1:3) for (metric in seq_len(ncol(metrics_of(trials[[set]])))) {
  x <- metrics_of(trials[[set]])[, metric]
  q <- quantile(x, c(0.25, 0.75), type = 7)
  text <- number(c(set - 1, metric - 1, mean(x), sd(x), median(x), t.test(x)$conf.int, t.test(x, conf.level = 0.99)$conf.int))
  box <- number(q)
  say("    {", paste(text, collapse = ", "), ", ", row_text(quantile(x, c(0, 0.05, 0.25, 1 / 3, 0.6, 0.975, 1), type = 7)), ", ",
      paste(box, collapse = ", "), "},")
}
say("};")

# Power, both tails (strict), and the smallest number of subjects by trying them in turn.
power_of <- function(dz, n, alpha)
  power.t.test(n = n, delta = dz, sd = 1, sig.level = alpha, type = "paired", strict = TRUE)$power
say("struct PowerRow {")
say("  double dz; int subjects; double power[3];  // of alpha = 0.05, 0.01, 0.001")
say("};")
say("inline constexpr PowerRow kPowers[] = {")
for (dz in c(0.1, 0.2, 0.5, 0.8, 1.2, 2.5)) for (n in c(2, 3, 12, 50, 500))
  say("    {", number(dz), ", ", n, ", ", row_text(sapply(c(0.05, 0.01, 0.001), function(a) power_of(dz, n, a))), "},")
say("};")
say("struct SubjectsRow {")
say("  double dz, power; int subjects[2];  // of alpha = 0.05, 0.01")
say("};")
smallest <- function(dz, power, alpha) {
  n <- 2
  while (power_of(dz, n, alpha) < power) n <- n + 1
  n
}
say("inline constexpr SubjectsRow kSubjects[] = {")
for (dz in c(0.1, 0.2, 0.5, 0.8, 1.2, 2.5, 6)) for (power in c(0.8, 0.9, 0.99))
  say("    {", number(dz), ", ", power, ", ", row_text(sapply(c(0.05, 0.01), function(a) smallest(dz, power, a))), "},")
say("};")

# Several tests: p.adjust.
p <- c(0.012, 1e-12, 0.04, 0.04, 0.0047, 4.05e-6, 0.73, 1, 0, 0.03, 5.67e-7, 0.5)
array("kRaw", p)
array("kHolm", p.adjust(p, "holm"))

# Wilcoxon's signed-rank test, one-sided: wilcox.test with zeros left out beforehand.  Exact up to 25 differences
# without ties, else the normal approximation; `count` differences a row, the rest of the row filled with zeros.
longest <- 60
say("struct SignedRankRow {")
say("  int count; double p; double differences[", longest, "];")
say("};")
heavy <- with(trials$Replicated, metric_3[condition == 1] - metric_3[condition == 4])
heavy <- c(heavy, with(trials$Replicated, metric_4[condition == 2] - metric_4[condition == 5] + 4),
           with(trials$Replicated, metric_1[condition == 3] - metric_1[condition == 6]))
paired <- function(set, a, b, metric) {
  y <- metrics_of(trials[[set]])[, metric]
  y[trials[[set]]$condition == a] - y[trials[[set]]$condition == b]
}
signed_rank_row <- function(d) {
  kept <- d[d != 0]
  ties <- any(duplicated(abs(kept)))
  r <- wilcox.test(kept, alternative = "greater", exact = length(kept) <= 25 && !ties, correct = TRUE)
  say("    {", length(d), ", ", number(r$p.value), ", ", row_text(c(d, rep(0, longest - length(d)))), "},")
}
say("inline constexpr SignedRankRow kSignedRanks[] = {")
for (d in list(3, -3, c(1, 2, 3, 4, 5), c(-1, -2, -3, -4, -5), paired(1, 2, 1, 1), paired(1, 1, 2, 1), paired(1, 2, 3, 2),
               paired(2, 1, 2, 2), heavy[1:10], heavy[1:25], c(heavy[1:12], 0, 0, heavy[13:20], 0), heavy[1:26],
               c(heavy[1:25], 0, 0), heavy[1:60], -heavy[1:60], abs(heavy[1:60]),
               round(paired(1, 2, 1, 1)), round(heavy[1:25], 0), round(heavy[1:60] / 2), rep(c(1, -1), c(8, 3))))
  signed_rank_row(d)
say("};")
say("}  // namespace stillhand::golden::statistics")
writeLines(out, "expected.hpp")
