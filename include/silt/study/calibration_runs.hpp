// silt - BSD-3-Clause, see LICENSE
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <silt/core/error.hpp>
#include <silt/files/atomic_file.hpp>
#include <silt/study/study_files.hpp>
#include <silt/study/study_table.hpp>

namespace silt::inline SILT_TARGET {

/// A parameter of a scene to calibrate.
struct CalibrationParameter {
  std::string name;          // with its unit: "friction [-]"
  double least, most;        // bounds, in that unit
  bool logarithmic = false;  // calibrate its logarithm; bounds above 0

  /// Its value at u in [0, 1], and u for a value.
  double value(double u) const {
    if (u <= 0 || u >= 1) return u <= 0 ? least : most;
    return logarithmic ? least * std::pow(most / least, u) : least + (most - least) * u;
  }
  double share(double value) const {
    const double u = logarithmic ? std::log(value / least) / std::log(most / least)
                                 : (value - least) / (most - least);
    return std::clamp(u, 0.0, 1.0);
  }
};

/// A measured quantity that the scene should reproduce.
struct CalibrationTarget {
  std::string name;  // with its unit
  double measured;
  double error;  // standard deviation of the measurement; determines the weight
};

/// One run of the scene.
struct CalibrationRun {
  std::size_t point = 0, repeat = 0;  // counted from 0
  std::string kind = {};              // design, filling, proposal or confirmation
  std::vector<double> parameters = {}, outputs = {};
  double chi2 = 0;           // [-] of this run
  double seconds = 0;        // [s] that it took
  std::string failure = {};  // reason; then there are no outputs
  bool failed() const { return !failure.empty(); }
};

namespace detail {

/// Runs of a calibration in FOLDER/calibration.csv. A row is on the disk when its run ends, before
/// the next begins. FOLDER/settings.txt has the settings.
class CalibrationJournal {
 public:
  CalibrationJournal(const std::string& folder, std::vector<CalibrationParameter> parameters,
                     std::vector<CalibrationTarget> targets, const std::string& settings)
      : parameters_(std::move(parameters)), targets_(std::move(targets)) {
    if (folder.empty()) return;
    make_folder(folder);
    const std::string path = folder + "/calibration.csv", known = folder + "/settings.txt";
    if (file_exists(known)) {
      check_settings(known, read_text(known), settings);
    } else {
      require(!file_exists(path), "Calibration: folder '", folder,
              "' has a calibration.csv but no settings.txt, which identifies it; choose "
              "another folder");
      write_whole(known, settings);
    }
    file_.emplace(path, O_WRONLY | O_APPEND | O_CREAT, path);
    require(file_->lock(), "Calibration: another program calibrates in '", folder,
            "' at this moment; choose another folder or wait for it");
    std::string content = read_text(path);
    const auto whole = content.rfind('\n') + 1;  // a kill may have left an incomplete row
    if (whole < content.size()) file_->truncate(whole), content.resize(whole);
    if (content.empty()) {
      append(header());
    } else {
      read(path, content);
    }
  }

  /// Runs of an earlier program, in their order.
  const std::vector<CalibrationRun>& earlier() const { return earlier_; }

  void add(std::size_t number, const CalibrationRun& run) {
    if (file_) append(row(number, run));
  }

 private:
  static void check_settings(const std::string& path, std::string_view there,
                             std::string_view now) {
    while (!there.empty() || !now.empty()) {
      const auto line = [](std::string_view& all) {
        const auto end = all.find('\n');
        const auto first = all.substr(0, end);
        all = end == all.npos ? std::string_view{} : all.substr(end + 1);
        return first;
      };
      const auto a = line(there), b = line(now);
      require(a == b, "Calibration: '", path, "' has runs of another calibration, with ",
              in_quotes(a, 120), " where this one has ", in_quotes(b, 120),
              "; choose another folder, or remove that one");
    }
  }

  std::string header() const {
    std::string out = "run,point,repeat,kind";
    for (const auto& p : parameters_) out += ',' + csv_cell(p.name);
    for (const auto& t : targets_) out += ',' + csv_cell(t.name);
    return out + ",chi2 [-],time [s],failure\n";
  }
  std::string row(std::size_t number, const CalibrationRun& run) const {
    std::string out = text(number, ',', run.point, ',', run.repeat, ',', run.kind);
    for (const double p : run.parameters) out += text(',', p);
    for (std::size_t t = 0; t < targets_.size(); ++t)
      out += run.failed() ? "," : text(',', run.outputs[t]);
    out += run.failed() ? "," : text(',', run.chi2);
    return out + text(',', run.seconds, ',') + csv_cell(run.failure) + '\n';
  }
  void append(const std::string& line) {
    file_->write(line.data(), line.size());
    file_->flush_to_disk();
  }

  void read(const std::string& path, std::string_view content) {
    const std::string first = header();
    if (!content.starts_with(first))
      throw FileError(text("file '", path,
                           "' does not begin with the columns of this calibration; "
                           "choose another folder"));
    content.remove_prefix(first.size());
    for (std::size_t number = 0; !content.empty(); ++number) {
      auto line = content.substr(0, content.find('\n'));
      content.remove_prefix(line.size() + 1);
      const auto refuse = [&] {
        throw FileError(text("file '", path, "', row ", number, ": ", in_quotes(line),
                             " is not a run of this calibration; remove it and all rows after it"));
      };
      const auto cell = [&] {
        const auto end = line.find(',');
        if (end == line.npos) refuse();
        const auto words = line.substr(0, end);
        line.remove_prefix(end + 1);
        return words;
      };
      const auto is_number = [](std::string_view words, auto& value) {
        const auto end = words.data() + words.size();
        const auto done = std::from_chars(words.data(), end, value);
        return done.ec == std::errc{} && done.ptr == end;
      };
      CalibrationRun run;
      std::size_t counted = 0;
      if (!is_number(cell(), counted) || counted != number || !is_number(cell(), run.point) ||
          !is_number(cell(), run.repeat))
        refuse();
      run.kind = cell();
      for (std::size_t k = 0; k < parameters_.size(); ++k)
        if (!is_number(cell(), run.parameters.emplace_back())) refuse();
      bool ended = true;
      for (std::size_t k = 0; k < targets_.size(); ++k)
        ended = is_number(cell(), run.outputs.emplace_back()) && ended;
      ended = is_number(cell(), run.chi2) && ended;
      if (!is_number(cell(), run.seconds)) refuse();
      if (line.starts_with('"') && line.ends_with('"') && line.size() > 1) {
        for (line = line.substr(1, line.size() - 2); !line.empty(); line.remove_prefix(1)) {
          run.failure += line[0];
          if (line.starts_with("\"\"")) line.remove_prefix(1);
        }
      } else {
        run.failure = line;
      }
      if (ended == run.failed()) refuse();
      if (run.failed()) run.outputs.clear();
      earlier_.push_back(std::move(run));
    }
  }

  std::vector<CalibrationParameter> parameters_;
  std::vector<CalibrationTarget> targets_;
  std::optional<File> file_;
  std::vector<CalibrationRun> earlier_;
};

}  // namespace detail
}  // namespace silt
