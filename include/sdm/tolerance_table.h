/// Tables of tolerances in files.
///
/// Threads: the function may be called concurrently.
#pragma once

#include <sdm/api.h>
#include <sdm/group_verdicts.h>

#include <filesystem>
#include <vector>

namespace sdm {

/// Reads the tolerances of groups: CSV with the header "group,lower,upper", or a JSON array of objects with
/// these keys. A name with a comma stands between quotation marks in CSV. With the header
/// "group;lower;upper", semicolons separate, and the decimal mark may be a comma. A side without a limit is
/// empty, in JSON null or left out. Throws sdm::Error, naming the file and the line, for a limit that is no
/// finite number, a lower limit above the upper one, a row without a limit, a group without a name or with
/// two rows, and a table without rows.
[[nodiscard]] SDM_API std::vector<GroupTolerance> read_tolerance_table(const std::filesystem::path& file);

}  // namespace sdm
