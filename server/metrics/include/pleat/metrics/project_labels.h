// Names of projects as labels, of which there are never too many.
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <set>
#include <string>

namespace pleat {

// Prometheus keeps a series for every label that it has ever seen. So the first projects have
// labels of their own and all later ones share "other", until the process ends. Thread-safe.
class ProjectLabels {
 public:
  static constexpr size_t kMaxLabels = 64;
  explicit ProjectLabels(size_t max_labels = kMaxLabels) : max_labels_(max_labels) {}

  // An empty project, of a call that was not let in, is "none".
  std::string LabelOf(const std::string& project) {
    if (project.empty()) return "none";
    std::lock_guard lock(mutex_);
    if (labels_.contains(project)) return project;
    if (labels_.size() >= max_labels_) return "other";
    labels_.insert(project);
    return project;
  }

 private:
  const size_t max_labels_;
  std::mutex mutex_;
  std::set<std::string> labels_;  // guarded by mutex_
};

}  // namespace pleat
