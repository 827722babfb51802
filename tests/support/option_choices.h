// Every choice of every training option.
#pragma once

#include <type_traits>

#include "pleat/character/train_options.h"

namespace pleat {

// Calls visit(option name, choice name, options) for every name of every option that has names;
// `options` are the defaults with that choice.
template <typename Visitor>
void ForEachChoice(Visitor&& visit) {
  TrainOptions options;
  VisitTrainOptions(options, [&](const char* option, auto& value) {
    using T = std::decay_t<decltype(value)>;
    if constexpr (std::is_enum_v<T>) {
      const T kept = value;
      for (const NamedChoice<T>& choice : ChoicesOf<T>()) {
        value = choice.value;
        visit(option, choice.name, options);
      }
      value = kept;
    }
  });
}

}  // namespace pleat
