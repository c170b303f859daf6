// The options of signed distances.
#pragma once

#include <sdm/options.h>
#include <sdm/sites.h>

namespace sdm {
namespace js {

struct SignedDistanceOptions {
  SignMethod sign = SignMethod::automatic;
};

}  // namespace js

template <>
inline constexpr std::tuple kOptions<js::SignedDistanceOptions>{
    Option{.name = "sign", .member = &js::SignedDistanceOptions::sign, .text = kSignText}};

}  // namespace sdm
