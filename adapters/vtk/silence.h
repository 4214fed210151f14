#pragma once
/// \file VTK's messages, kept instead of printed.

#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>
#include <vtkSmartPointer.h>

#include <iostream>
#include <sstream>
#include <string>

namespace vasohex {

/// Keeps VTK's messages instead of printing them.
class MessageKeeper : public vtkOutputWindow {
 public:
  static MessageKeeper* New();
  vtkTypeMacro(MessageKeeper, vtkOutputWindow);
  void DisplayText(const char* text) override { text_ += text; }
  void DisplayErrorText(const char* text) override { text_ += text; }
  void DisplayWarningText(const char* text) override { text_ += text; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};
inline vtkStandardNewMacro(MessageKeeper);

/// While it lives, nothing that VTK and its helpers print is seen.
class Silence {
 public:
  Silence()
      : window_(vtkOutputWindow::GetInstance()), cerr_(std::cerr.rdbuf(printed_.rdbuf())),
        cout_(std::cout.rdbuf(printed_.rdbuf())) {
    vtkOutputWindow::SetInstance(keeper_);
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  }
  ~Silence() {
    vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_INFO);
    vtkOutputWindow::SetInstance(window_);
    std::cout.rdbuf(cout_);
    std::cerr.rdbuf(cerr_);
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

  bool complained() const { return keeper_->text().find("ERROR") != std::string::npos || !printed_.str().empty(); }
  /// The first complaint, one line, without the names of sources and addresses.
  std::string complaint() const {
    std::string text = keeper_->text().empty() ? printed_.str() : keeper_->text();
    if (const std::size_t address = text.find("): "); address != std::string::npos) {
      text = text.substr(address + 3);
    }
    text = text.substr(0, text.find('\n'));
    return text;
  }

 private:
  std::ostringstream printed_;
  vtkNew<MessageKeeper> keeper_;
  vtkSmartPointer<vtkOutputWindow> window_;
  std::streambuf* cerr_;
  std::streambuf* cout_;
};

}  // namespace vasohex
