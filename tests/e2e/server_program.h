// pleatd on a free port of the loopback interface, over a data folder.
#pragma once

#include <signal.h>

#include <memory>
#include <string>
#include <vector>

#include "e2e/process.h"

namespace pleat {

class ServerProgram {
 public:
  // flags: further ones.
  explicit ServerProgram(const std::string& data_folder, const std::vector<std::string>& flags = {})
      : process_(Command(data_folder, flags)) {}

  // The address it listens on, empty when it did not come up.
  std::string WaitForAddress() {
    const std::string sign = "listening on ";
    if (!process_.WaitForText(sign)) return "";
    const std::string log = process_.out() + process_.err();
    const size_t begin = log.find(sign) + sign.size();
    return log.substr(begin, log.find_first_of(" \n\"", begin) - begin);
  }
  std::string log() const { return process_.out() + process_.err(); }

  void Signal(int number) { process_.Signal(number); }
  ProcessResult Stop() {
    process_.Signal(SIGTERM);
    return process_.Wait(20);
  }

 private:
  static std::vector<std::string> Command(const std::string& data_folder,
                                          const std::vector<std::string>& flags) {
    std::vector<std::string> command = {
        ProgramPath("pleatd"), "--listen",       "127.0.0.1:0", "--data-dir",
        data_folder,           "--job-priority", "normal"};
    command.insert(command.end(), flags.begin(), flags.end());
    return command;
  }

  Process process_;
};

}  // namespace pleat
