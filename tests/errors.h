#pragma once
/// \file What a function complains about.

#include <gtest/gtest.h>

#include <string>

#include "vasohex/core/error.h"

namespace vasohex {

/// The message of the Error that `f` throws, which must be about bad input and one line; empty if it throws none.
template <class F>
std::string error_of(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::bad_input);
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    return e.what();
  }
  return "";
}

}  // namespace vasohex
