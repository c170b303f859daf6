// The writers of fields.
#pragma once

#include <sdm/volume.h>

#include <ostream>

namespace sdm::io {

void write_field_npy(std::ostream& out, const DistanceField& field);
void write_field_vti(std::ostream& out, const DistanceField& field);
void write_field_vdb(std::ostream& out, const DistanceField& field);

}  // namespace sdm::io
