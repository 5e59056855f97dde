int sim_stub(void) { return 0; }
