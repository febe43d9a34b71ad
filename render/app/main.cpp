#include "render/app/program.h"

int main(int argc, char** argv) {
    return render::run_program({argv + 1, argv + argc});
}
