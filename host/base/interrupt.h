// Copyright 2026 The Vitrine Authors. SPDX-License-Identifier: Apache-2.0
//
// Ctrl-C as a flag: the handler only sets it, and Progress::advance turns it into Interrupted where stages can unwind.
#pragma once

namespace vitrine {

// From here on SIGINT and SIGTERM set the flag. A second one while the first is still being unwound ends the process at once
// (stores are written atomically, so nothing is lost but work).
void install_interrupt_handler();
bool interrupt_requested();
// Sets the flag as the signal would; and clears it. For tests.
void request_interrupt();
void clear_interrupt();

}  // namespace vitrine
