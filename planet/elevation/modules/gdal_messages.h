#pragma once
// GDAL's messages are kept off the terminal; the last failure becomes part of ours.

#include <cpl_error.h>

#include <string>

namespace planet {

class GdalMessages {
  public:
    GdalMessages() { CPLPushErrorHandlerEx(keep, this); }
    ~GdalMessages() { CPLPopErrorHandler(); }
    GdalMessages(const GdalMessages&) = delete;
    GdalMessages& operator=(const GdalMessages&) = delete;

    const std::string& last() const { return last_; }

  private:
    static void CPL_STDCALL keep(CPLErr severity, CPLErrorNum, const char* text) {
        if (severity < CE_Failure) return;
        static_cast<GdalMessages*>(CPLGetErrorHandlerUserData())->last_ = text;
    }
    std::string last_;
};

}  // namespace planet
